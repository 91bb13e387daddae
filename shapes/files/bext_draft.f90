module bext_draft
  !! BEXT, as text and as JSON, lists elements as node ids and ids of coefficient vectors, and the
  !! vectors behind them: row a of C is vector id a, and vectors are shared between elements. This
  !! is what is kept until all vectors are there.
  use kinds, only: wp
  use growing_arrays, only: make_room
  use extraction_mesh, only: extraction_mesh_type, problem_list, largest_degree, whole_number
  implicit none (type, external)
  private
  public :: bext_draft_type, element_block, block_problem

  type :: element_block
    integer :: elements = 0          !! how many
    integer :: functions = 0         !! of each
    integer :: vectors = 0           !! of each
    integer :: degree(3) = -1        !! -1 (or 0): the direction is not there
    integer :: line = 0
  end type element_block

  type :: bext_draft_type
    integer :: ne = 0, nv = 0
    integer, allocatable :: block_of(:)              !! (ne)
    integer, allocatable :: line(:)                  !! of each element (ne)
    integer, allocatable :: first(:)                 !! of its nodes and vectors, less one (ne)
    integer, allocatable :: nodes(:), vectors(:)     !! from 1
    integer, allocatable :: vector_first(:)          !! of the components, less one (nv)
    integer, allocatable :: vector_size(:)           !! (nv)
    real(wp), allocatable :: components(:)
    integer, private :: used = 0, used_components = 0
  contains
    procedure :: add_element
    procedure :: add_vector
    procedure :: build
  end type bext_draft_type

contains

  pure function block_problem(block) result(fact)
    !! '' if the numbers of a block can be right.
    type(element_block), intent(in) :: block
    character(:), allocatable :: fact

    fact = ''
    if (block%elements < 0) then
      fact = 'the number of elements is negative'
    else if (block%functions < 1) then
      fact = 'elements have no functions'
    else if (block%functions /= block%vectors) then
      fact = 'elements have ' // whole_number(block%functions) // ' functions and ' // &
        whole_number(block%vectors) // ' coefficient vectors'
    else if (block%degree(1) < 1 .or. any(block%degree > largest_degree)) then
      fact = 'degrees must lie between 1 and ' // whole_number(largest_degree)
    else if (block%degree(3) > 0 .and. block%degree(2) < 1) then
      fact = 'there is a third degree without a second'
    end if
  end function block_problem

  subroutine add_element(self, block, nodes, vectors, line)
    class(bext_draft_type), intent(inout) :: self
    integer, intent(in) :: block                     !! number of its block
    integer, intent(in) :: nodes(:), vectors(:)      !! from 1, as many of either
    integer, intent(in) :: line                      !! of the file

    integer :: n

    n = size(nodes)
    self%ne = self%ne + 1
    call make_room(self%block_of, self%ne)
    call make_room(self%line, self%ne)
    call make_room(self%first, self%ne)
    call make_room(self%nodes, self%used + n)
    call make_room(self%vectors, self%used + n)
    self%block_of(self%ne) = block
    self%line(self%ne) = line
    self%first(self%ne) = self%used
    self%nodes(self%used+1:self%used+n) = nodes
    self%vectors(self%used+1:self%used+n) = vectors
    self%used = self%used + n
  end subroutine add_element

  subroutine add_vector(self, components)
    class(bext_draft_type), intent(inout) :: self
    real(wp), intent(in) :: components(:)

    integer :: n

    n = size(components)
    self%nv = self%nv + 1
    call make_room(self%vector_first, self%nv)
    call make_room(self%vector_size, self%nv)
    call make_room(self%components, self%used_components + n)
    self%vector_first(self%nv) = self%used_components
    self%vector_size(self%nv) = n
    self%components(self%used_components+1:self%used_components+n) = components
    self%used_components = self%used_components + n
  end subroutine add_vector

  subroutine build(self, blocks, first, mesh, problems)
    !! The elements, now that all vectors are there.
    class(bext_draft_type), intent(in) :: self
    type(element_block), intent(in) :: blocks(:)
    integer, intent(in) :: first                     !! the file's id of the first vector
    type(extraction_mesh_type), intent(inout) :: mesh
    type(problem_list), intent(inout) :: problems

    real(wp), allocatable :: ce(:,:)
    integer :: a, at, dp, e, n, nb, v
    logical :: good

    do e = 1, self%ne
      associate (block => blocks(self%block_of(e)))
        n = block%functions
        dp = count(block%degree > 0)
        nb = product(block%degree(1:dp) + 1)
        at = self%first(e)
        good = .true.
        do a = 1, n
          v = self%vectors(at+a)
          if (v < 1 .or. v > self%nv) then
            call problems%add(self%line(e), 'element ' // whole_number(e-1+first) // &
              ' names coefficient vector ' // whole_number(v-1+first) // ', which does not exist', &
              'Vectors are numbered from ' // whole_number(first) // ' to ' // &
              whole_number(self%nv-1+first))
          else if (self%vector_size(v) /= nb) then
            call problems%add(self%line(e), 'element ' // whole_number(e-1+first) // &
              ': coefficient vector ' // whole_number(v-1+first) // ' has ' // &
              whole_number(self%vector_size(v)) // ' components', 'Its degrees need ' // &
              whole_number(nb))
          else
            cycle
          end if
          good = .false.
          exit
        end do
        if (.not. good) cycle
        if (allocated(ce)) then
          if (size(ce, 1) /= n .or. size(ce, 2) /= nb) deallocate (ce)
        end if
        if (.not. allocated(ce)) allocate (ce(n,nb))
        do a = 1, n
          v = self%vectors(at+a)
          ce(a,:) = self%components(self%vector_first(v)+1:self%vector_first(v)+nb)
        end do
        call mesh%add_element(block%degree(1:dp), self%nodes(at+1:at+n), ce, self%line(e))
      end associate
    end do
  end subroutine build
end module bext_draft
