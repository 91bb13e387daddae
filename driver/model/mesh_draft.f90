module mesh_draft
  !! The model while its deck is being read: nodes and elements as they come, and what can only be
  !! carried out at END, because it names nodes and sets that may follow: ties, sets, conditions,
  !! loads, interfaces, histories.
  use kinds, only: wp
  use messages, only: deck_place, string, lower_case
  use model_data, only: model_type, surface_load_type, history_request
  use growing_arrays, only: make_room
  use nurbs_patch, only: nurbs_patch_type
  implicit none (type, external)
  private
  public :: append_value
  public :: draft_type, element_origin, set_request, value_request, tie_request, load_request, &
    interface_request, &
    history_draft, link_request, end_face_request, named_operator, patch_part, shell_request, &
    joint_request

  type :: element_origin
    !! The data set that elements come from.
    type(deck_place) :: at
    character(:), allocatable :: command   !! PATCh, BEZIer, ELEMents, T-SPline
    character(:), allocatable :: name      !! of a patch or a mesh file; else ''
    integer :: first = 0, last = 0         !! its elements
    logical :: is_open = .false.           !! more elements may follow
  end type element_origin

  type :: set_request
    !! A SET command.
    type(deck_place) :: at
    character(:), allocatable :: name
    character(4) :: keyword = ''              !! node, elem, surf, unio, box, corn
    type(string), allocatable :: names(:)     !! sets that it is made of
    real(wp), allocatable :: numbers(:)       !! nodes, elements, elements and sides, bounds
  end type set_request

  type :: value_request
    !! A record of BOUNdary, DISPlacement, FORCe or FPROportional.
    type(deck_place) :: at
    character(:), allocatable :: set          !! its nodes; else first, first+step, ..., last
    integer :: first = 0, last = 0, step = 1
    logical :: keeps = .false.                !! all take v1
    real(wp), allocatable :: v1(:), v2(:)     !! values of the components at first and at last
  end type value_request

  type :: tie_request
    type(deck_place) :: at
    real(wp) :: tol = 1e-9_wp                 !! relative to the size of the model
    type(string), allocatable :: names(:)     !! patches; none: patches of one body
  end type tie_request

  type :: load_request
    type(deck_place) :: at
    character(:), allocatable :: set
    type(surface_load_type) :: load
  end type load_request

  type :: interface_request
    type(deck_place) :: at
    character(:), allocatable :: slave, master
  end type interface_request

  type :: end_face_request
    type(deck_place) :: at
    character(:), allocatable :: name, surface
    logical :: has_value = .false., turns = .false.   !! a rotation, else a moment
    real(wp) :: value = 0                     !! at factor 1
    integer :: prop = 0                       !! time function (0: sum of all)
    logical :: warps = .false.
    logical :: has_axis = .false.
    real(wp) :: axis(3) = 0
  end type end_face_request

  type :: history_draft
    type(deck_place) :: at
    character(:), allocatable :: set          !! '' : the whole model, or an end face
    character(:), allocatable :: end_face     !! unallocated: none
    character(:), allocatable :: surface      !! of a material point; unallocated: none
    real(wp) :: point(3) = 0                  !! the point
    type(history_request) :: request
  end type history_draft

  type :: link_request
    !! u(comp) of the slave = constant + sum of coefs*u(comps) of the masters.
    type(deck_place) :: at
    character(:), allocatable :: slave        !! node number or set
    integer :: comp = 0
    real(wp) :: constant = 0
    type(string), allocatable :: masters(:)   !! node numbers or sets of one node
    integer, allocatable :: comps(:)
    real(wp), allocatable :: coefs(:)
  end type link_request

  type :: shell_request
    !! CLAMp, SYMMetry: a condition on an edge of a shell.
    type(deck_place) :: at
    character(4) :: keyword = ''              !! clam, symm
    character(:), allocatable :: set          !! the edge
  end type shell_request

  type :: joint_request
    !! JOINt: seams between shells.
    type(deck_place) :: at
    type(string), allocatable :: names(:)     !! surfaces or element sets
    real(wp) :: stiffness = 1000              !! relative
    logical :: is_hinge = .false.
  end type joint_request

  type :: named_operator
    !! OPERator: an extraction operator that several elements share.
    type(deck_place) :: at
    integer :: id = 0                         !! its number in the deck
    integer :: op = 0                         !! its number in the extraction set; 0: it was faulty
  end type named_operator

  type :: patch_part
    !! A patch with the line PARTial: not in the mesh, to be merged with another one.
    type(deck_place) :: at
    character(:), allocatable :: name
    type(nurbs_patch_type) :: patch
    integer :: material = 1, body = 1         !! as in the deck
    logical :: is_taken = .false.             !! by a MERGe
  end type patch_part

  type :: draft_type
    type(deck_place) :: header                  !! of FEAP
    type(deck_place) :: last_at                 !! of the node defined last
    integer :: numnp = 0, numel = 0, nummat = 0 !! announced counts, 0: to be counted
    integer :: nn = 0                           !! nodes so far (highest number)
    real(wp), allocatable :: x(:, :), w(:)      !! control points (ndm,nn), weights
    logical, allocatable :: defined(:)          !! has coordinates (nn)
    integer, allocatable :: material(:)         !! material number of each element as in the deck
    integer, allocatable :: body(:)             !! body of each element
    integer, allocatable :: line(:), order(:)   !! of each element's record
    integer :: lost_elements = 0                !! that were not added because of errors
    logical :: has_lost_sets = .false.          !! some sets are empty because of errors
    logical :: has_lost_file = .false.          !! a mesh file has errors, its sets are unknown
    type(element_origin), allocatable :: origins(:)
    type(named_operator), allocatable :: operators(:)
    type(patch_part), allocatable :: parts(:)
    type(set_request), allocatable :: sets(:)
    type(tie_request), allocatable :: ties(:)
    type(value_request), allocatable :: boundary(:), displacement(:), force(:), proportional(:)
    integer :: n_boundary = 0, n_displacement = 0, n_force = 0, n_proportional = 0
    type(link_request), allocatable :: links(:)
    type(shell_request), allocatable :: shell_conditions(:)
    type(joint_request), allocatable :: joints(:)
    type(load_request), allocatable :: loads(:)
    type(interface_request), allocatable :: interfaces(:)
    type(end_face_request), allocatable :: end_faces(:)
    type(history_draft), allocatable :: histories(:)
    integer, allocatable :: tied_to(:)          !! after TIE: the node that stands for each (nn)
  contains
    procedure :: start
    procedure :: set_node
    procedure :: note_elements
    procedure :: element_place
    procedure :: element_name
    procedure :: set_names_so_far
    procedure :: add_part
    procedure :: find_part
  end type draft_type

contains

  subroutine start(self, model)
    class(draft_type), intent(inout) :: self
    type(model_type), intent(inout) :: model

    allocate (self%x(model%ndm, 0), self%w(0), self%defined(0))
    allocate (self%parts(0))
    allocate (self%origins(0), self%operators(0), self%sets(0), self%ties(0), self%links(0), &
      self%loads(0), &
      self%interfaces(0), self%end_faces(0), self%histories(0), self%shell_conditions(0), &
      self%joints(0))
    allocate (self%boundary(0), self%displacement(0), self%force(0), self%proportional(0))
    allocate (model%sets(0), model%materials(0), model%props(0), model%links(0), model%loads(0), &
      model%interfaces(0), model%histories(0), model%exports(0))
    allocate (model%outputs%steps(0), model%outputs%times(0))
    call model%mesh%init()
  end subroutine start

  subroutine set_node(self, n, x, w)
    class(draft_type), intent(inout) :: self
    integer, intent(in) :: n              !! node
    real(wp), intent(in) :: x(:)          !! control point (ndm) [length]
    real(wp), intent(in) :: w             !! weight

    call make_room(self%x, n)
    call make_room(self%w, n)
    call make_room(self%defined, n)
    self%nn = max(self%nn, n)
    self%x(:, n) = x
    self%w(n) = w
    self%defined(n) = .true.
  end subroutine set_node

  subroutine note_elements(self, first, last, material, body, at)
    !! Elements were added to the mesh by the data set that is the last of self%origins.
    class(draft_type), intent(inout) :: self
    integer, intent(in) :: first, last    !! elements
    integer, intent(in) :: material       !! material number of the deck
    integer, intent(in) :: body
    type(deck_place), intent(in) :: at    !! of their record

    call make_room(self%material, last)
    call make_room(self%body, last)
    call make_room(self%line, last)
    call make_room(self%order, last)
    self%material(first:last) = material
    self%body(first:last) = body
    self%line(first:last) = at%line
    self%order(first:last) = at%order
    associate (origin => self%origins(size(self%origins)))
      if (origin%first == 0) origin%first = first
      origin%last = last
    end associate
  end subroutine note_elements

  function element_place(self, e) result(at)
    class(draft_type), intent(in) :: self
    integer, intent(in) :: e              !! element
    type(deck_place) :: at
    integer :: i

    i = origin_of(self, e)
    if (i == 0) return
    at = self%origins(i)%at
    at%line = self%line(e)
    at%order = self%order(e)
  end function element_place

  function element_name(self, e) result(command)
    !! The command and the patch that an element comes from: PATCh die.
    class(draft_type), intent(in) :: self
    integer, intent(in) :: e              !! element
    character(:), allocatable :: command
    integer :: i

    command = ''
    i = origin_of(self, e)
    if (i == 0) return
    command = self%origins(i)%command
    if (len(self%origins(i)%name) > 0) command = command // ' ' // self%origins(i)%name
  end function element_name

  function set_names_so_far(self, model) result(names)
    !! Sets of patches and of SET commands that were read.
    class(draft_type), intent(in) :: self
    type(model_type), intent(in) :: model
    type(string), allocatable :: names(:)
    integer :: i, n

    n = size(model%sets)
    allocate (names(n + size(self%sets)))
    do i = 1, n
      names(i)%s = model%sets(i)%name
    end do
    do i = 1, size(self%sets)
      names(n + i)%s = self%sets(i)%name
    end do
  end function set_names_so_far

  subroutine add_part(self, part)
    class(draft_type), intent(inout) :: self
    type(patch_part), intent(in) :: part
    type(patch_part), allocatable :: larger(:)
    integer :: i, n

    n = size(self%parts)
    allocate (larger(n + 1))
    do i = 1, n
      larger(i) = self%parts(i)
    end do
    larger(n + 1) = part
    call move_alloc(larger, self%parts)
  end subroutine add_part

  integer function find_part(self, name)
    !! Index of the patch of this name; 0 if there is none.
    class(draft_type), intent(in) :: self
    character(*), intent(in) :: name

    do find_part = 1, size(self%parts)
      if (lower_case(self%parts(find_part)%name) == lower_case(name)) return
    end do
    find_part = 0
  end function find_part

  subroutine append_value(list, n, request)
    type(value_request), allocatable, intent(inout) :: list(:)
    integer, intent(inout) :: n                       !! requests in the list
    type(value_request), intent(in) :: request
    type(value_request), allocatable :: larger(:)
    integer :: i

    if (n == size(list)) then
      allocate (larger(max(16, 2*n)))
      do i = 1, n
        larger(i)%at = list(i)%at
        larger(i)%first = list(i)%first
        larger(i)%last = list(i)%last
        larger(i)%step = list(i)%step
        larger(i)%keeps = list(i)%keeps
        call move_alloc(list(i)%set, larger(i)%set)
        call move_alloc(list(i)%v1, larger(i)%v1)
        call move_alloc(list(i)%v2, larger(i)%v2)
      end do
      call move_alloc(larger, list)
    end if
    n = n + 1
    list(n) = request
  end subroutine append_value

  pure integer function origin_of(self, e)
    class(draft_type), intent(in) :: self
    integer, intent(in) :: e

    do origin_of = size(self%origins), 1, -1
      if (e >= self%origins(origin_of)%first .and. e <= self%origins(origin_of)%last) return
    end do
    origin_of = 0
  end function origin_of
end module mesh_draft
