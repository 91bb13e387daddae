module joint_lines
  !! Joints of shells (JOINt) in the equations: each is a small element on the functions of the two elements that meet.
  use kinds, only: wp
  use status_codes, only: ok
  use model_data, only: model_type
  use gauss_rules, only: gauss_legendre
  use user_element, only: task_tangent
  use edge_rows, only: edge_point, edge_point_at
  use shell_joint, only: joint_angle, joint_force
  use bulk_elements, only: add_moved_force
  use equation_system, only: equation_system_type
  implicit none (type, external)
  private
  public :: joint_line, prepare_joints, assemble_joints, joint_lists

  type :: joint_line
    integer, allocatable :: nodes(:)
    real(wp), allocatable :: dshp(:, :, :)     !! derivatives across from both sides and along (3,nen,ng)
    real(wp), allocatable :: start(:, :, :)    !! of the position at the start (3,3,ng)
    real(wp), allocatable :: length(:), cosine(:), sine(:)   !! of the points; of the angle at the start
    real(wp) :: stiffness = 0                  !! moment per length and angle [force]
    logical :: is_linear = .false.
  end type joint_line

contains

  subroutine prepare_joints(model, joints, status, place)
    type(model_type), intent(in), target :: model
    type(joint_line), allocatable, intent(out) :: joints(:)
    integer, intent(out) :: status
    integer, intent(out) :: place              !! the element at fault
    integer :: i, n

    status = ok
    place = 0
    n = 0
    if (allocated(model%joints)) n = size(model%joints)
    allocate (joints(n))
    do i = 1, n
      call prepare_joint(model, i, joints(i), status)
      place = model%joints(i)%element(1)
      if (status /= ok) return
    end do
  end subroutine prepare_joints

  subroutine prepare_joint(model, number, joint, status)
    type(model_type), intent(in), target :: model
    integer, intent(in) :: number
    type(joint_line), intent(out) :: joint
    integer, intent(out) :: status
    integer, pointer, contiguous :: ia(:), ib(:)
    type(edge_point) :: here, there, mirrored
    real(wp), allocatable :: eta(:), wt(:)
    real(wp) :: rigidity(2)
    logical :: is_linear(2)
    integer :: b, g, k, ng, place

    associate (asked => model%joints(number))
      ia => model%mesh%connectivity(asked%element(1))
      ib => model%mesh%connectivity(asked%element(2))
      joint%nodes = [ia, pack(ib, [(.not. any(ia == ib(b)), b=1, size(ib))])]
      ng = maxval(model%mesh%degree(1:2, asked%element)) + 1
      eta = [(0.0_wp, g=1, ng)]
      wt = eta
      call gauss_legendre(ng, eta, wt)
      allocate (joint%dshp(3, size(joint%nodes), ng), joint%start(3, 3, ng), source=0.0_wp)
      allocate (joint%length(ng), joint%cosine(ng), joint%sine(ng))
      do g = 1, ng
        call edge_point_at(model, asked%element(1), asked%side(1), eta(g), here, status)
        if (status /= ok) return
        call edge_point_at(model, asked%element(2), asked%side(2), 1 - eta(g), there, status)
        if (status /= ok) return
        call edge_point_at(model, asked%element(2), asked%side(2), eta(g), mirrored, status)
        if (status /= ok) return
        if (norm2(mirrored%x - here%x) < norm2(there%x - here%x)) there = mirrored
        joint%length(g) = norm2(here%tau)*wt(g)
        joint%dshp(1, 1:size(ia), g) = here%dnu
        joint%dshp(3, 1:size(ia), g) = here%dtau
        do b = 1, size(ib)
          place = findloc(joint%nodes, ib(b), 1)
          joint%dshp(2, place, g) = there%dnu(b)
        end do
        joint%start(:, :, g) = matmul(model%x(:, joint%nodes), transpose(joint%dshp(:, :, g)))
        call joint_angle(joint%start(:, :, g), joint%cosine(g), joint%sine(g), status)
        if (status /= ok) return
      end do
      do k = 1, 2
        call model%materials(model%material_of(asked%element(k)))%element%shell_facts(rigidity(k), is_linear(k))
      end do
      joint%is_linear = all(is_linear)
      joint%stiffness = asked%stiffness*maxval(rigidity)/sum(joint%length)
    end associate
  end subroutine prepare_joint

  subroutine joint_lists(joints, ptr, nodes)
    !! Append the nodes of each joint to lists, for the matrix pattern.
    type(joint_line), intent(in) :: joints(:)
    integer, allocatable, intent(inout) :: ptr(:), nodes(:)
    integer :: i

    do i = 1, size(joints)
      nodes = [nodes, joints(i)%nodes]
      ptr = [ptr, size(nodes) + 1]
    end do
  end subroutine joint_lists

  subroutine assemble_joints(joints, task, u, du, moves, system, f, f_moved, stored, status)
    type(joint_line), intent(in) :: joints(:)
    integer, intent(in) :: task                     !! task_residual or task_tangent
    real(wp), intent(in) :: u(:, :)                 !! control values (ndf,nn)
    real(wp), intent(in) :: du(:, :)                !! prescribed increments or rates (ndf,nn)
    logical, intent(in) :: moves(:)                 !! (nn) where du is not zero; size 0: nowhere
    type(equation_system_type), intent(inout) :: system
    real(wp), intent(inout) :: f(:, :), f_moved(:, :)
    real(wp), intent(inout) :: stored               !! energy
    integer, intent(out) :: status
    real(wp), allocatable :: fe(:, :), ke(:, :, :, :)
    real(wp) :: energy
    integer :: i, n

    status = ok
    do i = 1, size(joints)
      associate (joint => joints(i))
        n = size(joint%nodes)
        allocate (fe(3, n))
        if (task == task_tangent) then
          allocate (ke(3, n, 3, n))
        else
          allocate (ke(0, 0, 0, 0))
        end if
        call joint_force(joint%dshp, joint%start, joint%length, joint%cosine, joint%sine, joint%stiffness, &
          joint%is_linear, u(1:3, joint%nodes), fe, ke, energy, status)
        if (status /= ok) return
        stored = stored + energy
        f(1:3, joint%nodes) = f(1:3, joint%nodes) + fe
        if (task == task_tangent) then
          if (size(moves) > 0) then
            if (any(moves(joint%nodes))) call add_moved_force(ke, du, joint%nodes, .true., f_moved)
          end if
          call system%add_loose(joint%nodes, ke, .true.)
        end if
        deallocate (fe, ke)
      end associate
    end do
  end subroutine assemble_joints
end module joint_lines
