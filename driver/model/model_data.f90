module model_data
  !! What a deck describes: nodes, elements with their extraction, sets, materials, conditions, loads, interfaces,
  !! requested histories and outputs. Filled by the mesh commands, read by everything else; nothing of the solution
  !! in progress is kept here.
  use kinds, only: wp
  use extraction_set, only: extraction_set_type
  use user_element, only: element_type
  use messages, only: deck_place
  implicit none (type, external)
  private
  public :: model_type, named_set, material_type, time_function, surface_load_type, interface_type, bond_region, &
    history_request, output_request, linear_constraint, end_face_type, extraction_set_type, mesh_export, shell_joint_type
  public :: set_nodes, set_elements, set_surface

  integer, parameter :: set_nodes = 1, set_elements = 2, set_surface = 3

  type :: named_set
    character(:), allocatable :: name    !! as the deck writes it; compared without regard to case
    character(:), allocatable :: place   !! file:line
    integer :: kind = 0                  !! set_nodes, set_elements, set_surface
    integer, allocatable :: items(:)     !! nodes; elements; the elements of a surface
    integer, allocatable :: sides(:)     !! surface: side 1..2*dp of each element (0: the element itself, a shell)
  end type named_set

  type :: material_type
    integer :: number = 0
    character(:), allocatable :: name    !! first word after the number, may be empty
    character(:), allocatable :: place
    class(element_type), allocatable :: element
  end type material_type

  type :: time_function
    !! Piecewise linear in time, constant beyond its ends (PROP).
    integer :: number = 0
    real(wp), allocatable :: t(:), v(:)
  contains
    procedure :: at => time_function_at
    procedure :: slope => time_function_slope
  end type time_function

  type :: surface_load_type
    !! A load on a surface, or a body force on an element set.
    integer :: set = 0                   !! index into sets
    character(8) :: kind = ''            !! 'traction', 'pressure' (dead), 'follower', 'body'
    real(wp) :: value(3) = 0             !! vector; pressure in value(1), > 0 pushes against the surface
    integer :: prop = 0                  !! time function number (0: factor 1... the proportional load)
    integer :: gp = 0                    !! Gauss points per direction (0: degree + 1)
    character(:), allocatable :: place
  end type surface_load_type

  type :: bond_region
    !! A part of a cohesive interface that is bonded from the start, or is not.
    logical :: bonded = .true.                   !! BONDed; else UNBOnded
    character(:), allocatable :: name            !! of a surface; unallocated for a box
    integer :: set = 0                           !! its index into sets
    real(wp) :: low(3) = 0, high(3) = 0          !! a box of reference positions [length]
    type(deck_place) :: at
  end type bond_region

  type :: interface_type
    !! A pair of surfaces coupled by Gauss-point-to-surface elements.
    character(:), allocatable :: name, place
    integer :: slave = 0, master = 0     !! indices into sets (surfaces)
    integer :: gp = 2                    !! Gauss points per direction on each slave facet
    integer :: side = 1                  !! sign of the master's normal; 0: for shells, that which the start tells
    real(wp) :: offset = 0               !! distance of the surfaces at which the gap is 0 (half the thicknesses of
                                         !! shells) [length]
    real(wp) :: reach = 0                !! search distance [length], 0: chosen from facet sizes
    type(bond_region), allocatable :: regions(:)  !! with cohesion: what is bonded; none: everything
    class(element_type), allocatable :: element
  end type interface_type

  type :: end_face_type
    !! A surface that turns about an axis through its centroid (ENDFace), rigid or free to warp. Its angle, multiplier
    !! and translation are globals: components of columns behind those of the nodes in arrays of control values.
    character(:), allocatable :: name, place
    integer :: set = 0                   !! index into sets (surface)
    logical :: warps = .false.           !! only the mean rotation is that of the face
    real(wp) :: axis(3) = [0, 0, 1]      !! unit vector
    integer :: rotation = 0              !! column: component 1 the angle [rad], 2 the multiplier of a face that warps
    integer :: translation = 0           !! column: translation of the centroid; 0: the face warps
  end type end_face_type

  type :: history_request
    character(:), allocatable :: label, place
    integer :: set = 0                   !! node set or surface (index into sets), 0: the whole model
    logical :: reaction = .false.        !! <label>_rx,<label>_ry,<label>_rz: sums over the set
    logical :: displacement = .false.    !! <label>_ux,...: of the one node, or the mean over the set
    integer, allocatable :: nodes(:)     !! of the facet on which a material point lies; unallocated: none is asked for
    real(wp), allocatable :: shares(:)   !! the facet's functions there
    integer :: end_face = 0              !! index into end_faces
    logical :: moment = .false.          !! <label>_m: that the support (or the load) applies to the face
    logical :: rotation = .false.        !! <label>_rot: angle [rad]
    logical :: work = .false., elastic = .false., penalty = .false., dissipated = .false., penetration = .false.
    logical :: balance = .false.         !! energy_error
  end type history_request

  type :: output_request
    !! When fields and restart states are written (OUTPut, RESTart). The last step is always written.
    logical :: fields = .true.           !! .false.: no field output at all (OUTPut NONE)
    integer :: every = 0                 !! every so many steps; 0: only what follows and the last step
    integer, allocatable :: steps(:)     !! these steps
    real(wp), allocatable :: times(:)    !! these times
    integer :: restart_every = 20        !! steps between restart states; 0: none
  end type output_request

  type :: linear_constraint
    !! u(dof) = constant + sum coef * u(master dofs) (LINK).
    integer :: node = 0, comp = 0
    integer, allocatable :: nodes(:), comps(:)
    real(wp), allocatable :: coefs(:)
    real(wp) :: constant = 0
    character(:), allocatable :: place
  end type linear_constraint

  type :: shell_joint_type
    !! Two sides of shell elements that a rotational spring connects (JOINt).
    integer :: element(2) = 0, side(2) = 0
    real(wp) :: stiffness = 0            !! times bending rigidity over the length of the side
  end type shell_joint_type

  type :: mesh_export
    !! A file that the mesh is written to (EXPOrt).
    type(deck_place) :: at
    character(:), allocatable :: file    !! its name in the folder of the results
    logical :: is_text = .true.          !! .iga; else HDF5
  end type mesh_export

  type :: model_type
    character(:), allocatable :: title
    integer :: ndm = 0                               !! space dimension
    integer :: ndf = 0                               !! dofs per node (largest)
    integer :: nn = 0                                !! nodes (control points)
    real(wp), allocatable :: x(:, :)                 !! reference control points (ndm,nn) [length]
    real(wp), allocatable :: w(:)                    !! control weights (nn)
    type(extraction_set_type) :: mesh                !! all bulk elements
    integer, allocatable :: material_of(:)           !! (ne) index into materials
    integer, allocatable :: body_of(:)               !! (ne) body number for results
    type(named_set), allocatable :: sets(:)
    type(material_type), allocatable :: materials(:)
    type(time_function), allocatable :: props(:)
    ! conditions of the nodes' control values and, in further columns, of the globals
    logical, allocatable :: fixed(:, :)              !! (ndf,columns) the value is prescribed
    real(wp), allocatable :: disp(:, :)              !! (ndf,columns) its amplitude
    integer, allocatable :: disp_prop(:, :)          !! (ndf,columns) its time function (0: all props summed, as in FEAP)
    real(wp), allocatable :: force(:, :)             !! (ndf,columns) dead nodal forces
    integer, allocatable :: force_prop(:, :)         !! (ndf,columns)
    type(linear_constraint), allocatable :: links(:)
    integer :: globals = 0                           !! columns of globals
    type(end_face_type), allocatable :: end_faces(:)
    type(shell_joint_type), allocatable :: joints(:)
    type(surface_load_type), allocatable :: loads(:)
    type(interface_type), allocatable :: interfaces(:)
    type(history_request), allocatable :: histories(:)
    type(output_request) :: outputs
    type(mesh_export), allocatable :: exports(:)
  contains
    procedure :: columns
  end type model_type

contains

  pure integer function columns(self)
    !! Of arrays of control values: nodes, then globals.
    class(model_type), intent(in) :: self

    columns = self%nn + self%globals
  end function columns

  pure function time_function_at(self, time) result(value)
    class(time_function), intent(in) :: self
    real(wp), intent(in) :: time
    real(wp) :: value
    integer :: i, n

    n = size(self%t)
    if (time <= self%t(1)) then
      value = self%v(1)
      return
    end if
    do i = 2, n
      if (time <= self%t(i)) then
        value = self%v(i - 1) + (self%v(i) - self%v(i - 1))*((time - self%t(i - 1))/(self%t(i) - self%t(i - 1)))
        return
      end if
    end do
    value = self%v(n)
  end function time_function_at

  pure function time_function_slope(self, time) result(slope)
    !! Its rate; at a corner that of the piece that begins there.
    class(time_function), intent(in) :: self
    real(wp), intent(in) :: time
    real(wp) :: slope
    integer :: i

    slope = 0
    if (time < self%t(1)) return
    do i = 2, size(self%t)
      if (time < self%t(i)) then
        slope = (self%v(i) - self%v(i - 1))/(self%t(i) - self%t(i - 1))
        return
      end if
    end do
  end function time_function_slope
end module model_data
